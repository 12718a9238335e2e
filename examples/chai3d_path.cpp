// A Gliss surface in a CHAI3D world without a window or a device: a tool goes along the positions
// that it reads, and the force on it is written, a line each. The world's unit is the mesh's.
//
//   cmake ... -DGLISS_CHAI3D_DIR=CHAI3D/build && chai3d_path knot.obj mm < path.txt
//
// A line of path.txt is x y z, of the output fx,fy,fz in N.
#include <gliss/base/units.h>
#include <gliss/build/build_cache.h>
#include <gliss/chai3d.h>
#include <gliss/files/mesh_file.h>

#include <cstdio>

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "usage: chai3d_path MESH UNIT, such as mm, < positions in that unit\n");
    return 2;
  }
  try {
    const double unit = gliss::parse_unit(words[2]);
    gliss::Mesh mesh = gliss::load_mesh(words[1], {.unit = unit});
    const auto cache = std::make_shared<const gliss::PatchCache>(gliss::build_cache(mesh));

    chai3d::cWorld world;
    auto* object = new gliss::cGlissObject({.cache = cache}, unit);
    object->m_material->setStiffness(500 * unit);  // 500 N/m
    object->createDrawing(mesh);                   // a window would show it
    world.addChild(object);                        // the world deletes it
    chai3d::cToolCursor tool(&world);

    chai3d::cVector3d at, still;
    chai3d::cMatrix3d straight = chai3d::cIdentity3d();
    std::printf("fx,fy,fz\n");
    while (std::scanf("%lf %lf %lf", &at(0), &at(1), &at(2)) == 3) {  // the haptic loop
      const chai3d::cVector3d force =
          tool.m_hapticPoint->computeInteractionForces(at, straight, still, still);
      std::printf("%.17g,%.17g,%.17g\n", force(0), force(1), force(2));
    }
    return object->fault() == nullptr ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chai3d_path: %s\n", error.what());
    return 1;
  }
}
