// Holds what threads share: engines, sweeps with their parts, one cache asked by many threads.
// Small, so that it can run under ThreadSanitizer; results are those of one thread.
#include <thread>

#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "gliss/sweep/sweep_parts.h"
#include "tests/support/bytes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

constexpr int kThreads = 4;

// Patches of 4 sides on a knot and, in larger pieces than a thread takes at once, HIPs beneath
// them.
class Parallel : public ::testing::Test {
 protected:
  Parallel() {
    for (std::uint32_t face = 0; face < cache_.mesh_face_count; ++face) {
      for (int i = 0; i < 20; ++i) points_.push_back({face, 0.05 * i - 0.5, 0.1});
    }
    for (std::size_t i = 0; i < points_.size(); i += 10) {
      const SurfacePoint p = evaluate(cache_, points_[i]);
      hips_.push_back(p.position - 1.5 * p.normal);
      starts_.push_back(points_[i]);
    }
  }

  std::string contacts(const Engine& engine) const {
    const auto surface = engine.reside(cache_);
    std::vector<SurfacePoint> samples(points_.size());
    surface->evaluate(points_, samples);
    std::vector<Contact> found(3 * hips_.size()), tracked(hips_.size());
    const Method methods[] = {Method::kGregory, Method::kShaded, Method::kFlat};
    surface->nearest(hips_, methods, {}, found);
    surface->track(hips_, starts_, {}, tracked);
    std::string bytes;
    for (const SurfacePoint& s : samples) test::append(bytes, s.position.data(), 3);
    for (const auto* all : {&found, &tracked}) {
      for (const Contact& c : *all) test::append(bytes, c.scp.data(), 3);
    }
    return bytes;
  }

  const Mesh mesh_ = torus_knot(60, 8).mesh;
  const PatchCache cache_ = test::cache_of(mesh_);
  const std::unique_ptr<Engine> engine_ = make_tbb_engine(kThreads);
  std::vector<DomainPoint> points_, starts_;
  std::vector<Vec3> hips_;
};

TEST_F(Parallel, engine_takes_every_piece_once) {
  std::vector<int> taken(1000);
  engine_->for_each(taken.size(), 3, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++taken[i];
  });
  EXPECT_EQ(taken, std::vector<int>(1000, 1));
}

TEST_F(Parallel, build_gives_the_bytes_of_one_thread) {
  EXPECT_EQ(test::bytes_of(engine_->build(mesh_)), test::bytes_of(cache_));
}

TEST_F(Parallel, contacts_are_those_of_one_thread) {
  EXPECT_EQ(contacts(*engine_), contacts(*make_serial_engine()));
}

TEST_F(Parallel, sweep_with_parts_gives_the_bytes_of_one_thread) {
  SweepOptions options;
  options.depths = {1e-3};
  options.methods = {Method::kGregory, Method::kFlat};
  options.rings = 3;
  options.part_contacts = 4'000;
  const std::string want = test::swept(cache_, *make_serial_engine(), options);
  const test::ScratchFolder folder;
  SweepParts parts(folder / "parts", cache_, options, true);
  EXPECT_EQ(test::swept(cache_, *engine_, options, &parts), want);
  EXPECT_EQ(parts.kept(), 2u);
  EXPECT_EQ(test::swept(cache_, *engine_, options, &parts), want);  // read again
}

TEST_F(Parallel, threads_ask_one_cache_at_once) {
  const auto surface = engine_->reside(cache_);
  std::vector<std::string> forces(kThreads);
  const auto ask = [&](std::string& bytes) {
    trace(cache_, std::span(hips_).first(60), {},
          [&](std::size_t, std::span<const TraceStep> steps) {
            for (const TraceStep& step : steps) test::append(bytes, step.force.data(), 3);
          });
    std::vector<Contact> found(hips_.size());
    surface->project(hips_, {}, found);
    for (const Contact& c : found) test::append(bytes, c.scp.data(), 3);
    const Contact one = nearest(cache_, hips_[7]);
    EXPECT_EQ(one.scp, found[7].scp);
  };
  {
    std::vector<std::jthread> threads;
    for (std::string& bytes : forces) threads.emplace_back([&] { ask(bytes); });
  }
  EXPECT_GT(forces[0].size(), hips_.size() * sizeof(Vec3));
  for (const std::string& bytes : forces) EXPECT_EQ(bytes, forces[0]);
}

}  // namespace
}  // namespace gliss
