// gliss generate: meshes made by formula, in millimetres.
#include <fmt/format.h>

#include <limits>
#include <optional>
#include <type_traits>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {
namespace {

struct GenerateOptions : CommonOptions {
  std::string output;
  int along = 0, around = 0, frequency = 0, sides = 0;
  double major = 0, minor = 0, tube = 0;  // mm, as all below
  std::optional<std::uint64_t> irregular;
  bool without_normals = false;
  double radius = 0, cavity = 0, height = 0, width = 0, thickness = 0, base = 0, length = 0;
};

struct Shape {
  const char *name, *description, *example;
  void (*describe)(Command&, GenerateOptions&);
  Generated (*make)(const GenerateOptions&);
  bool has_surface = false;  // an exact one, which random triangles may lie on
};

template <class Number>
void add(Command& command, const char* name, Number& value, Number initial,
         const char* description) {
  constexpr bool kCount = std::is_same_v<Number, int>;
  value = initial;
  command.option({name, kCount ? "N" : "MM", fmt::format("{}; default {}", description, initial)},
                 value, kCount ? Number(1) : std::numeric_limits<Number>::min(), Number(1'000'000));
}

const Shape kShapes[] = {
    {"knot", "Tube round the (2, 3) torus knot.", "--along 240 --around 24",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 120, "faces along the knot");
       add(c, "--around", o.around, 12, "faces around the tube");
       add(c, "--major", o.major, 33.0, "radius of the torus");
       add(c, "--minor", o.minor, 17.0, "radius of the winding");
       add(c, "--tube", o.tube, 12.0, "radius of the tube");
     },
     [](const GenerateOptions& o) {
       return torus_knot(o.along, o.around, o.major, o.minor, o.tube);
     },
     true},
    {"torus", "Torus of quads.", "--major 30 --minor 10",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 24, "faces along the ring");
       add(c, "--around", o.around, 12, "faces around the tube");
       add(c, "--major", o.major, 30.0, "radius of the ring");
       add(c, "--minor", o.minor, 10.0, "radius of the tube");
     },
     [](const GenerateOptions& o) { return torus(o.along, o.around, o.major, o.minor); }, true},
    {"goldberg", "Sphere of 12 pentagons and hexagons.", "--frequency 4",
     [](Command& c, GenerateOptions& o) {
       add(c, "--frequency", o.frequency, 4, "10 (N^2 - 1) hexagons");
       add(c, "--radius", o.radius, 10.0, "radius of the sphere");
     },
     [](const GenerateOptions& o) { return goldberg(o.frequency, o.radius); }, true},
    {"hollow", "Ball with a cavity.", "--radius 20 --cavity 10",
     [](Command& c, GenerateOptions& o) {
       add(c, "--frequency", o.frequency, 4, "10 (N^2 - 1) hexagons, of each wall");
       add(c, "--radius", o.radius, 20.0, "radius of the ball");
       add(c, "--cavity", o.cavity, 10.0, "radius of the cavity");
     },
     [](const GenerateOptions& o) {
       return nested_balls({o.radius, -o.cavity}, o.frequency);
     }},
    {"ellipsoid", "Ellipsoid of 12 pentagons and hexagons.", "--length 40 --width 24 --height 16",
     [](Command& c, GenerateOptions& o) {
       add(c, "--frequency", o.frequency, 4, "10 (N^2 - 1) hexagons");
       add(c, "--length", o.length, 40.0, "size in x");
       add(c, "--width", o.width, 24.0, "size in y");
       add(c, "--height", o.height, 16.0, "size in z");
     },
     [](const GenerateOptions& o) { return ellipsoid(o.frequency, o.length, o.width, o.height); },
     true},
    {"banana", "Banana of quads with two end caps.", "--along 37 --around 11",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 37, "faces from end to end");
       add(c, "--around", o.around, 11, "faces around; sides of the caps");
     },
     [](const GenerateOptions& o) { return banana(o.along, o.around); }},
    {"prism", "Prism with n-gon caps.", "--sides 300",
     [](Command& c, GenerateOptions& o) {
       add(c, "--sides", o.sides, 6, "sides of the caps");
       add(c, "--radius", o.radius, 10.0, "radius of the caps");
       add(c, "--height", o.height, 10.0, "distance of the caps");
     },
     [](const GenerateOptions& o) { return prism(o.sides, o.radius, o.height); }},
    {"cylinder", "Cylinder with n-gon caps; normals differ across its rims.", "--around 48",
     [](Command& c, GenerateOptions& o) {
       add(c, "--around", o.around, 24, "faces around; sides of the caps");
       add(c, "--along", o.along, 2, "faces from cap to cap");
       add(c, "--radius", o.radius, 10.0, "radius of the caps");
       add(c, "--height", o.height, 20.0, "distance of the caps");
     },
     [](const GenerateOptions& o) { return cylinder(o.around, o.along, o.radius, o.height); },
     true},
    {"cube", "Cube of squares; normals differ across its edges.", "--along 4",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 1, "faces along an edge");
       add(c, "--width", o.width, 10.0, "size");
     },
     [](const GenerateOptions& o) { return cube(o.along, o.width); }},
    {"plate", "Thin closed plate.", "--width 30 --thickness 0.5",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 12, "faces in x");
       add(c, "--around", o.around, 12, "faces in y");
       add(c, "--width", o.width, 30.0, "size in x and y");
       add(c, "--thickness", o.thickness, 0.5, "size in z");
     },
     [](const GenerateOptions& o) { return thin_plate(o.along, o.around, o.width, o.thickness); }},
    {"fin", "Fin with a sharp ridge.", "--height 15 --base 4",
     [](Command& c, GenerateOptions& o) {
       add(c, "--along", o.along, 16, "faces along the ridge");
       add(c, "--height", o.height, 15.0, "height of the ridge");
       add(c, "--base", o.base, 4.0, "width of the foot");
       add(c, "--length", o.length, 30.0, "length of the ridge");
     },
     [](const GenerateOptions& o) { return fin(o.along, o.height, o.base, o.length); }},
};

void write(const GenerateOptions& options, const Generated& made) {
  save_obj(made.mesh, options.output, command_line(), stop_if_interrupted);
  report(options,
         fmt::format("{}: {} faces, {} vertices, unit mm\n", options.output, made.mesh.face_count(),
                     made.mesh.positions.size()),
         {{"output", options.output},
          {"faces", made.mesh.face_count()},
          {"vertices", made.mesh.positions.size()},
          {"unit", "mm"}});
}

}  // namespace

void add_generate(Command& program) {
  Command& generate =
      program.add_command("generate", "Make a mesh by formula, an OBJ in millimetres.");
  generate.set_footer("Example: gliss generate knot -o knot.obj");
  for (const Shape& shape : kShapes) {
    add_command<GenerateOptions>(
        generate, shape.name, shape.description,
        fmt::format("gliss generate {0} {1} -o {0}.obj", shape.name, shape.example),
        [&shape](Command& command, GenerateOptions& options) {
          command.option({"-o,--output", "FILE", "OBJ file to write", true},
                         [&options](const std::string& path) {
                           if (!path.ends_with(".obj"))
                             throw InputError(fmt::format("'{}' must end in .obj", path));
                           options.output = path;
                         });
          if (shape.has_surface) {
            command.option(
                {"--irregular", "SEED",
                 "random triangles instead, on the shape's exact surface; sharp edges stay"},
                [&options](const std::string& text) {
                  options.irregular = parse_number<std::uint64_t>("--irregular", text);
                });
          }
          command.flag("--without-normals", options.without_normals,
                       "leave out the exact vertex normals");
          shape.describe(command, options);
        },
        [&shape](const GenerateOptions& options) {
          Generated made = shape.make(options);
          stop_if_interrupted();
          if (options.irregular) made = irregular(std::move(made), *options.irregular);
          if (options.without_normals) made.mesh.normals.clear(), made.mesh.corner_normal.clear();
          write(options, made);
        });
  }
}

}  // namespace gliss::tools
