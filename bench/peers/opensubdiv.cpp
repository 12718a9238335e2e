#include <benchmark/benchmark.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/bufferDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuPatchTable.h>

#include <memory>

#include "bench/peers/peers.h"
#include "bench/samples.h"

namespace gliss::bench {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;
namespace Sdc = OpenSubdiv::Sdc;

struct Vertex {
  float at[3];
  void Clear() { *this = {}; }
  void AddWithWeight(const Vertex& v, float weight) {
    for (int i = 0; i < 3; ++i) at[i] += weight * v.at[i];
  }
};

class Quads {
 public:
  explicit Quads(const Mesh& mesh) {
    const std::vector<int> sides(mesh.face_count(), 4),
        corners(mesh.corner_vertex.begin(), mesh.corner_vertex.end());
    Far::TopologyDescriptor description;
    description.numVertices = static_cast<int>(mesh.positions.size());
    description.numFaces = static_cast<int>(mesh.face_count());
    description.numVertsPerFace = sides.data();
    description.vertIndicesPerFace = corners.data();
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    const std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(description, Factory::Options(Sdc::SCHEME_CATMARK, Sdc::Options())));
    Far::PatchTableFactory::Options options(0);
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    table_.reset(Far::PatchTableFactory::Create(*refiner, options));
    for (const Vec3& p : mesh.positions) {
      const Eigen::Vector3f f = p.cast<float>();
      vertices_.push_back({{f.x(), f.y(), f.z()}});
    }
    vertices_.resize(vertices_.size() + static_cast<std::size_t>(table_->GetNumLocalPoints()));
    if (table_->GetNumLocalPoints() > 0)
      table_->ComputeLocalPointValues(vertices_.data(), &vertices_[mesh.positions.size()]);
    patches_ = std::make_unique<Osd::CpuPatchTable>(table_.get());
    map_ = std::make_unique<Far::PatchMap>(*table_);
  }

  Osd::PatchCoord coord(std::uint32_t face, const QuadPoint& p) const {
    const float u = p.u, v = p.v;
    return {
        *map_->FindPatch(static_cast<int>(face), static_cast<double>(u), static_cast<double>(v)), u,
        v};
  }

  // out: position and two derivatives, [3][count][3].
  void evaluate(const Osd::PatchCoord* at, std::size_t count, float* out) const {
    const Osd::BufferDescriptor triples(0, 3, 3);
    Osd::CpuEvaluator::EvalPatches(vertices_[0].at, triples, out, triples, out + 3 * count, triples,
                                   out + 6 * count, triples, static_cast<int>(count), at,
                                   patches_->GetPatchArrayBuffer(), patches_->GetPatchIndexBuffer(),
                                   patches_->GetPatchParamBuffer());
  }

 private:
  std::unique_ptr<Far::PatchTable> table_;
  std::vector<Vertex> vertices_;
  std::unique_ptr<Osd::CpuPatchTable> patches_;
  std::unique_ptr<Far::PatchMap> map_;
};

}  // namespace

Work opensubdiv_evaluate(const Mesh& mesh, Order order) {
  const auto quads = std::make_shared<Quads>(mesh);
  const CallPoints<double> points(order, mesh.face_count());
  std::vector<QuadPoint> places;
  for (std::size_t i = 0; i < kCallPoints; ++i)
    places.push_back(quad_point(points.xi[i], points.eta[i]));
  const auto out = std::make_shared<std::vector<float>>(9 * kCallPoints);
  return {static_cast<double>(kCallPoints),
          [=, faces = points.patch, coords = std::vector<Osd::PatchCoord>(kCallPoints)]() mutable {
            for (std::size_t i = 0; i < kCallPoints; ++i)
              coords[i] = quads->coord(faces[i], places[i]);
            quads->evaluate(coords.data(), kCallPoints, out->data());
            benchmark::DoNotOptimize(out->data());
          }};
}

}  // namespace gliss::bench
