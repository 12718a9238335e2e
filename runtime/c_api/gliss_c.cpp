#include "gliss/c_api/gliss_c.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/require.h"
#include "gliss/base/units.h"
#include "gliss/contact/tracker.h"
#include "gliss/device/guard.h"
#include "gliss/engine/engine.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/files/open_file.h"
#include "gliss/surface/names.h"

static_assert(sizeof(gliss_contact) == 128);

struct gliss_surface {
  std::atomic<std::size_t> holders{1};
  std::unique_ptr<gliss::Engine> engine;
  std::shared_ptr<const gliss::PatchCache> cache;
  std::unique_ptr<gliss::ResidentSurface> resident;  // of the two
};

struct gliss_hand {
  std::vector<gliss_surface*> surfaces;  // one for each object
  gliss::Tracker tracker;
  std::size_t hips;
  gliss::Nanoseconds tick, time{0};  // time: of the last tick
};

struct gliss_guard {
  gliss::Guard guard;
  gliss::GuardReason reason = gliss::GuardReason::kNone;  // of the last step
};

namespace {

using gliss::require, gliss::Vec3;

constexpr std::int32_t kInternal = 1, kBadInput = 2, kBadCache = 3;
constexpr std::size_t kBlock = 65536;  // points that are asked for at once
thread_local char last_error[512];     // so that telling an error asks for no memory

std::int32_t fail(std::int32_t code, const char* what) noexcept {
  std::strncpy(last_error, what, sizeof last_error - 1);
  return code;
}

// Does what may throw, and tells how it ended.
template <class Act>
std::int32_t attempt(const Act& act) noexcept {
  const gliss::PlainArithmetic plain;
  last_error[0] = 0;
  try {
    act();
    return 0;
  } catch (const gliss::MeshError& error) {
    return fail(kBadInput, error.what());
  } catch (const gliss::NoFileError& error) {
    return fail(kBadInput, error.what());
  } catch (const gliss::UnitError& error) {
    return fail(kBadInput, error.what());
  } catch (const gliss::CacheError& error) {
    return fail(kBadCache, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(kBadInput, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kInternal, "not enough memory");
  } catch (const std::exception& error) {
    return fail(kInternal, error.what());
  } catch (...) {
    return fail(kInternal, "an error of no known kind");
  }
}

void need(const void* pointer, const char* what) { require(pointer != nullptr, what); }

Vec3 vector_of(const double* v) { return {v[0], v[1], v[2]}; }
void store(const Vec3& v, double* to) { std::copy_n(v.data(), 3, to); }

constexpr char kNoRotation[] = "rotation: is not a unit quaternion w, x, y, z";

// The rotation of w, x, y, z at a position; nothing where that is invalid, but for numbers that are
// not finite: these are Tracker::step's to tell.
std::optional<gliss::Pose> find_pose(const double* rotation, const double* position) noexcept {
  const gliss::Rotation turn(rotation[0], rotation[1], rotation[2], rotation[3]);
  if (turn.coeffs().allFinite() && !(std::abs(turn.norm() - 1) < 1e-3)) return std::nullopt;
  gliss::Pose pose = gliss::Pose::Identity();
  pose.linear() = turn.normalized().toRotationMatrix();
  pose.translation() = vector_of(position);
  return pose;
}
// The same. Throws std::invalid_argument.
gliss::Pose pose_of(const double* rotation, const double* position) {
  const std::optional<gliss::Pose> pose = find_pose(rotation, position);
  require(pose && pose->linear().allFinite(), kNoRotation);
  return *pose;
}

gliss::Method method_of(std::uint32_t method) {
  switch (method) {
    case GLISS_GREGORY:
      return gliss::Method::kGregory;
    case GLISS_SHADED:
      return gliss::Method::kShaded;
    case GLISS_FLAT:
      return gliss::Method::kFlat;
    default:
      throw std::invalid_argument(
          "method: is not one of GLISS_GREGORY, GLISS_SHADED and GLISS_FLAT");
  }
}

gliss_options checked(const gliss_options* given) {
  constexpr std::size_t kFirstSize = offsetof(gliss_options, crease);  // until ABI 1.2
  gliss_options chosen = GLISS_OPTIONS_INIT;
  if (given == nullptr) return chosen;
  require(given->size == sizeof(gliss_options) || given->size == kFirstSize,
          "gliss_options: begin with GLISS_OPTIONS_INIT of the library's own header");
  std::memcpy(&chosen, given, given->size);
  require(chosen.precision <= GLISS_FLOAT, "precision: is neither GLISS_DOUBLE nor GLISS_FLOAT");
  require(chosen.construction <= GLISS_PAPER,
          "construction: is neither GLISS_FAIR nor GLISS_PAPER");
  require(chosen.unit > 0 && std::isfinite(chosen.unit), "unit: is not above 0");
  require(chosen.threads <= 4096, "threads: are more than 4096");
  require(chosen.orient <= GLISS_AS_GIVEN, "orient: is neither GLISS_OUTWARD nor GLISS_AS_GIVEN");
  return chosen;
}

gliss::LoadOptions load_options(const gliss_options& options) {
  gliss::LoadOptions load;
  load.unit = options.unit;
  if (options.crease != nullptr) load.creases = gliss::parse_creases(options.crease);
  load.orient = options.orient == GLISS_AS_GIVEN ? gliss::Orient::kFile : gliss::Orient::kOutward;
  load.flip = options.flip != 0;
  return load;
}

gliss::BuildOptions build_options(const gliss_options& options) {
  gliss::BuildOptions build;
  build.precision =
      options.precision == GLISS_FLOAT ? gliss::Precision::kFloat : gliss::Precision::kDouble;
  std::optional<gliss::Level> level;
  if (options.level != nullptr) {
    level = gliss::find_level(options.level);
    if (!level) throw std::invalid_argument(gliss::no_level(options.level));
  }
  build.level =
      gliss::chosen_level(level, options.construction == GLISS_PAPER ? gliss::Construction::kPaper
                                                                     : gliss::Construction::kFair);
  return build;
}

// A surface of what `make` makes with the engine.
template <class Make>
gliss_surface* surface_of(const gliss_options& options, const Make& make) {
  auto surface = std::make_unique<gliss_surface>();
  surface->engine = gliss::make_tbb_engine(static_cast<int>(options.threads));
  surface->cache = std::make_shared<const gliss::PatchCache>(make(*surface->engine));
  surface->resident = surface->engine->reside(*surface->cache);
  return surface.release();
}

void store(const gliss::Contact& from, gliss_contact* to) {
  *to = gliss_contact{};
  to->touching = from.touching ? 1 : 0;
  to->face = from.at.face;
  to->xi = from.at.xi;
  to->eta = from.at.eta;
  store(from.scp, to->scp);
  store(from.normal, to->normal);
  store(from.push, to->push);
  to->distance = from.distance;
  to->flags = from.flags;
  to->iterations = static_cast<std::uint32_t>(from.iterations);
}

template <class Real>
Vec3 point_at(const void* points, std::size_t stride, std::size_t i) {
  Real p[3];
  std::memcpy(p, static_cast<const char*>(points) + i * stride, sizeof p);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

gliss_object usual_object() {
  const gliss::SceneObject usual;
  gliss_object object{};
  object.size = sizeof object;
  object.stiffness = usual.stiffness;
  object.rotation[0] = 1;
  object.settle = usual.settle;
  object.texture_along[0] = 1;
  object.tick = gliss::ContactTracker::kTick;
  return object;
}

void require_object_size(std::size_t size) {
  require(size == sizeof(gliss_object),
          "gliss_object: begin with gliss_object_init() of a header that the library knows");
}

gliss::SceneObject object_of(const gliss_object& from) {
  require_object_size(from.size);
  need(from.surface, "gliss_object: surface is NULL");
  gliss::SceneObject object;
  object.cache = from.surface->cache;
  object.method = method_of(from.method);
  object.stiffness = from.stiffness;
  object.pose = pose_of(from.rotation, from.position);
  object.settle = from.settle;
  object.friction = {from.friction_static, from.friction_dynamic, from.friction_settle};
  object.effects.damping = from.damping;
  object.effects.viscosity = from.viscosity;
  object.effects.magnet = {from.magnet_force, from.magnet_range};
  require(from.texture <= 2, "texture: is not one of 0, 1 and 2");
  constexpr gliss::Relief kReliefs[] = {gliss::Relief::kNone, gliss::Relief::kGrating,
                                        gliss::Relief::kNoise};
  object.effects.texture = {kReliefs[from.texture], from.texture_height, from.texture_period,
                            vector_of(from.texture_along)};
  return object;
}

// ns, where a tick is not told another.
std::int64_t next_time(const gliss_hand& hand) {
  return (std::min(hand.time, gliss::Nanoseconds::max() - hand.tick) + hand.tick).count();
}

}  // namespace

std::uint32_t gliss_abi_version(void) { return GLISS_ABI; }
const char* gliss_version(void) { return GLISS_VERSION; }
const char* gliss_last_error(void) { return last_error; }

std::int32_t gliss_surface_load(const char* path, const gliss_options* options,
                                gliss_surface** out) {
  return attempt([&] {
    need(path, "path: is NULL");
    need(out, "out: is NULL");
    const gliss_options chosen = checked(options);
    *out = surface_of(chosen, [&](const gliss::Engine& engine) {
      if (gliss::is_meant_as_cache(path)) return gliss::load_cache(path);
      return engine.build(gliss::load_mesh(path, load_options(chosen)), build_options(chosen));
    });
  });
}

std::int32_t gliss_surface_from_arrays(const double* points, std::size_t stride,
                                       std::size_t vertices, const std::uint32_t* begin,
                                       const std::uint32_t* corners, std::size_t faces,
                                       const gliss_options* options, gliss_surface** out) {
  return attempt([&] {
    need(points, "points: is NULL");
    need(begin, "begin: is NULL");
    need(corners, "corners: is NULL");
    need(out, "out: is NULL");
    const gliss_options chosen = checked(options);
    require(vertices < gliss::kNone && faces < gliss::kNone, "vertices and faces: too many");
    gliss::Mesh mesh;
    mesh.source = "the arrays";
    mesh.unit = chosen.unit;
    for (std::size_t i = 0; i < vertices; ++i)
      mesh.positions.push_back(point_at<double>(points, stride == 0 ? 24 : stride, i));
    require(begin[0] == 0, "begin: does not begin with 0");
    for (std::size_t i = 0; i < faces; ++i) require(begin[i] <= begin[i + 1], "begin: decreases");
    mesh.face_begin.assign(begin, begin + faces + 1);
    mesh.corner_vertex.assign(corners, corners + begin[faces]);
    *out = surface_of(chosen, [&](const gliss::Engine& engine) {
      gliss::take_mesh(mesh, load_options(chosen));
      return engine.build(mesh, build_options(chosen));
    });
  });
}

void gliss_surface_retain(gliss_surface* surface) {
  if (surface != nullptr) surface->holders.fetch_add(1, std::memory_order_relaxed);
}

void gliss_surface_release(gliss_surface* surface) {
  if (surface != nullptr && surface->holders.fetch_sub(1, std::memory_order_acq_rel) == 1)
    delete surface;
}

std::int32_t gliss_surface_save(const gliss_surface* surface, const char* path) {
  return attempt([&] {
    need(surface, "surface: is NULL");
    need(path, "path: is NULL");
    gliss::save_cache(*surface->cache, path);
  });
}

double gliss_surface_unit(const gliss_surface* surface) {
  return surface == nullptr ? 0 : surface->cache->unit;
}

std::size_t gliss_surface_faces(const gliss_surface* surface) {
  return surface == nullptr ? 0 : surface->cache->mesh_face_count;
}

std::int32_t gliss_surface_bounds(const gliss_surface* surface, double low[3], double high[3]) {
  return attempt([&] {
    need(surface, "surface: is NULL");
    need(low, "low: is NULL");
    need(high, "high: is NULL");
    const gliss::Box box = surface->cache->bounds();
    store(box.low, low);
    store(box.high, high);
  });
}

std::int32_t gliss_surface_departure(const gliss_surface* surface, double* distance, double* room,
                                     std::uint32_t* face) {
  return attempt([&] {
    need(surface, "surface: is NULL");
    need(distance, "distance: is NULL");
    need(room, "room: is NULL");
    need(face, "face: is NULL");
    const gliss::Departure& d = surface->cache->tightest;
    *distance = d.distance;
    *room = d.room;
    *face = d.face;
  });
}

std::int32_t gliss_surface_nearest(const gliss_surface* surface, std::uint32_t method,
                                   const void* points, std::size_t stride, std::size_t bytes,
                                   std::size_t count, gliss_contact* out) {
  return attempt([&] {
    need(surface, "surface: is NULL");
    gliss::QueryOptions query;
    query.method = method_of(method);
    require(bytes == 4 || bytes == 8, "bytes: of a number are 4 or 8");
    if (count == 0) return;
    need(points, "points: is NULL");
    need(out, "out: is NULL");
    if (stride == 0) stride = 3 * bytes;
    const auto point = [&](std::size_t i) {
      return bytes == 4 ? point_at<float>(points, stride, i) : point_at<double>(points, stride, i);
    };
    for (std::size_t i = 0; i < count; ++i)
      require(point(i).allFinite(), "points: one is not finite");
    std::vector<Vec3> hips;
    std::vector<gliss::Contact> contacts;
    for (std::size_t first = 0; first < count; first += kBlock) {
      const std::size_t many = std::min(kBlock, count - first);
      hips.clear();
      for (std::size_t i = first; i < first + many; ++i) hips.push_back(point(i));
      contacts.resize(many);
      surface->resident->project(hips, query, contacts);
      for (std::size_t i = 0; i < many; ++i) store(contacts[i], out + first + i);
    }
  });
}

std::int32_t gliss_surface_evaluate(const gliss_surface* surface, const std::uint32_t* face,
                                    const double* xi, const double* eta, std::size_t count,
                                    double* positions, double* normals) {
  return attempt([&] {
    need(surface, "surface: is NULL");
    if (count == 0) return;
    need(face, "face: is NULL");
    need(xi, "xi: is NULL");
    need(eta, "eta: is NULL");
    for (std::size_t i = 0; i < count; ++i)
      require(face[i] < gliss_surface_faces(surface) &&
                  gliss::in_domain(*surface->cache, {face[i], xi[i], eta[i]}),
              "a point is in the domain of no face that has a patch");
    gliss::SurfaceArrays<double> out;
    if (positions != nullptr) out.position = gliss::strided_vectors(positions);
    if (normals != nullptr) out.normal = gliss::strided_vectors(normals);
    surface->resident->evaluate(gliss::PointArrays<double>{count, {face}, {xi}, {eta}}, out);
  });
}

std::int32_t gliss_object_set_defaults(gliss_object* object, std::size_t size) {
  return attempt([&] {
    need(object, "object: is NULL");
    require_object_size(size);
    *object = usual_object();
  });
}

std::int32_t gliss_hand_create(const gliss_object* objects, std::size_t count, const double* points,
                               std::size_t hips, gliss_hand** out) {
  return attempt([&] {
    need(out, "out: is NULL");
    require(count == 0 || objects != nullptr, "objects: is NULL");
    require(hips == 0 || points != nullptr, "points: is NULL");
    std::vector<gliss::SceneObject> scene;
    std::vector<gliss_surface*> surfaces;
    for (std::size_t i = 0; i < count; ++i) {
      scene.push_back(object_of(objects[i]));
      surfaces.push_back(objects[i].surface);
    }
    const double tick = count == 0 ? gliss::ContactTracker::kTick : objects[0].tick;
    require(tick >= 1e-6 && tick <= 1, "tick: is not from 1e-6 to 1 s");
    for (std::size_t i = 1; i < count; ++i)
      require(objects[i].tick == tick, "tick: is not the same in all objects");
    std::vector<Vec3> tool;
    for (std::size_t i = 0; i < hips; ++i) tool.push_back(vector_of(points + 3 * i));
    *out = new gliss_hand{std::move(surfaces), gliss::Tracker(scene, tool),
                          std::max<std::size_t>(hips, 1),
                          gliss::Nanoseconds(std::llround(1e9 * tick))};
    for (gliss_surface* surface : (*out)->surfaces) gliss_surface_retain(surface);
  });
}

void gliss_hand_release(gliss_hand* hand) {
  if (hand == nullptr) return;
  const std::vector<gliss_surface*> surfaces = std::move(hand->surfaces);
  delete hand;
  for (gliss_surface* surface : surfaces) gliss_surface_release(surface);
}

std::int32_t gliss_hand_tick(gliss_hand* hand, const double position[3], double force[3]) {
  if (hand == nullptr || position == nullptr || force == nullptr)
    return fail(kBadInput, "hand, position or force: is NULL");
  return gliss_hand_tick_at(hand, next_time(*hand), position, nullptr, nullptr, force, nullptr);
}

std::int32_t gliss_hand_tick_tool(gliss_hand* hand, const double position[3],
                                  const double rotation[4], double force[3], double torque[3]) {
  if (hand == nullptr || position == nullptr || rotation == nullptr || force == nullptr ||
      torque == nullptr)
    return fail(kBadInput, "hand, position, rotation, force or torque: is NULL");
  return gliss_hand_tick_at(hand, next_time(*hand), position, nullptr, rotation, force, torque);
}

std::int32_t gliss_hand_tick_at(gliss_hand* hand, std::int64_t time_ns, const double position[3],
                                const double* velocity, const double* rotation, double force[3],
                                double* torque) {
  if (hand == nullptr || position == nullptr || force == nullptr)
    return fail(kBadInput, "hand, position or force: is NULL");
  const gliss::PlainArithmetic plain;
  last_error[0] = 0;
  constexpr double kIdentity[] = {1, 0, 0, 0};
  const auto tool = find_pose(rotation == nullptr ? kIdentity : rotation, position);
  if (!tool) return fail(kBadInput, kNoRotation);
  hand->time = gliss::Nanoseconds(time_ns);
  const gliss::Wrench wrench = hand->tracker.step(
      *tool, hand->time, velocity == nullptr ? Vec3(Vec3::Zero()) : vector_of(velocity));
  store(wrench.force, force);
  if (torque != nullptr) store(wrench.torque, torque);
  return 0;
}

std::int32_t gliss_hand_contact(const gliss_hand* hand, std::size_t hip, std::size_t object,
                                gliss_contact* out) {
  if (hand == nullptr || out == nullptr) return fail(kBadInput, "hand or out: is NULL");
  last_error[0] = 0;
  if (hip >= hand->hips || object >= hand->surfaces.size())
    return fail(kBadInput, "hip or object: there is none of that index");
  store(hand->tracker.objects()[hip * hand->surfaces.size() + object].contact, out);
  return 0;
}

std::int32_t gliss_hand_move(gliss_hand* hand, std::size_t object, const double rotation[4],
                             const double position[3]) {
  return attempt([&] {
    need(hand, "hand: is NULL");
    need(rotation, "rotation: is NULL");
    need(position, "position: is NULL");
    require(object < hand->surfaces.size(), "object: there is none of that index");
    require(hand->tracker.move(object, pose_of(rotation, position)), "position: is not finite");
  });
}

std::int32_t gliss_guard_create(double max_force, double max_rate, gliss_guard** out) {
  const gliss::GuardLimits usual;
  return gliss_guard_create_tool(max_force, max_rate, usual.max_torque, usual.max_torque_rate, out);
}

std::int32_t gliss_guard_create_tool(double max_force, double max_rate, double max_torque,
                                     double max_torque_rate, gliss_guard** out) {
  return attempt([&] {
    need(out, "out: is NULL");
    gliss::GuardLimits limits;
    limits.max_force = max_force;
    limits.max_rate = max_rate;
    limits.max_torque = max_torque;
    limits.max_torque_rate = max_torque_rate;
    *out = new gliss_guard{gliss::Guard(limits)};
  });
}

void gliss_guard_release(gliss_guard* guard) { delete guard; }

std::int32_t gliss_guard_step(gliss_guard* guard, std::int64_t now_ns, std::int64_t measured_ns,
                              const double wanted[3], double force[3], std::uint32_t* state) {
  constexpr double kNoTorque[3] = {};
  double torque[3];
  return gliss_guard_step_tool(guard, now_ns, measured_ns, wanted, kNoTorque, force, torque, state);
}

std::int32_t gliss_guard_step_tool(gliss_guard* guard, std::int64_t now_ns,
                                   std::int64_t measured_ns, const double wanted[3],
                                   const double wanted_torque[3], double force[3], double torque[3],
                                   std::uint32_t* state) {
  if (guard == nullptr || wanted == nullptr || wanted_torque == nullptr || force == nullptr ||
      torque == nullptr)
    return fail(kBadInput, "guard, wanted, wanted_torque, force or torque: is NULL");
  last_error[0] = 0;
  const gliss::GuardOutput out = guard->guard.step(
      std::chrono::nanoseconds(now_ns),
      {vector_of(wanted), std::chrono::nanoseconds(measured_ns), vector_of(wanted_torque)});
  guard->reason = out.reason;
  store(out.force, force);
  store(out.torque, torque);
  if (state != nullptr) *state = static_cast<std::uint32_t>(out.state);
  return 0;
}

std::int32_t gliss_guard_trip(gliss_guard* guard, std::int32_t is_fault) {
  if (guard == nullptr) return fail(kBadInput, "guard: is NULL");
  last_error[0] = 0;
  guard->guard.trip(is_fault != 0 ? gliss::GuardReason::kDeviceFault
                                  : gliss::GuardReason::kStopRequested);
  return 0;
}

const char* gliss_guard_reason(const gliss_guard* guard) {
  return gliss::guard_reason_name(guard == nullptr ? gliss::GuardReason::kNone : guard->reason);
}

std::int32_t gliss_guard_engage(gliss_guard* guard) {
  if (guard == nullptr) return fail(kBadInput, "guard: is NULL");
  last_error[0] = 0;
  return guard->guard.engage() ? 0 : fail(kBadInput, "the guard does not permit it yet");
}
