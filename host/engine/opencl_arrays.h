// The arrays of a surface in a device's memory.
#pragma once

#include "gliss/engine/opencl_queue.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/surface.h"

namespace gliss {

template <class Real>
constexpr Precision kPrecision = sizeof(Real) == 4 ? Precision::kFloat : Precision::kDouble;

// Throws where they do not fit.
template <class Real>
struct DeviceSurface {
  cl::Buffer domain, domain_begin, side_begin, side_patch, side_twin, control, control_begin, form,
      corner, patch, triangle, node, child, tile, tile_begin, part, part_table, partner, part_box;
  cl_uint patch_count;
  PatchKinds kinds;
  std::uint64_t bytes = 0;

  DeviceSurface(const Device& device, const Surface<Real>& s) : patch_count(s.patch_count()) {
    for (std::uint32_t p = 0; p < patch_count; ++p) kinds.add(s.form[p], s.valence(p));
    if (!s.part.empty()) kinds.forms |= kFormsUnited;
    for_each_array(
        s, [&](cl::Buffer&, const auto& array) { bytes += array.size() * sizeof(array[0]); });
    device.require_room(bytes, "the patches need");
    const cl::CommandQueue queue(device.context(), device.id());
    for_each_array(s, [&](cl::Buffer& buffer, const auto& array) {
      const std::size_t length = array.size() * sizeof(array[0]);
      buffer = device.buffer(length, CL_MEM_READ_ONLY, "the patches");
      if (length > 0) queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, length, array.data());
    });
  }

  template <class F>
  void for_each_array(const Surface<Real>& s, F f) {
    f(domain, s.domain);
    f(domain_begin, s.domain_begin);
    f(side_begin, s.side_begin);
    f(side_patch, s.side_patch);
    f(side_twin, s.side_twin);
    f(control, s.control);
    f(control_begin, s.control_begin);
    f(form, s.form);
    f(corner, s.corner);
    f(patch, s.patch);
    f(triangle, s.triangle);
    f(node, s.node);
    f(child, s.child);
    f(tile, s.tile);
    f(tile_begin, s.tile_begin);
    f(part, s.part);
    f(part_table, s.part_table);
    f(partner, s.partner);
    f(part_box, s.part_box);
  }

  Launch launch(const Device& device, const char* program, const char* name, int lanes) const {
    return {device,     program,      name,          ProgramVariant{kPrecision<Real>, lanes, kinds},
            domain,     domain_begin, side_begin,    side_patch,
            side_twin,  control,      control_begin, form,
            corner,     patch,        triangle,      node,
            child,      tile,         tile_begin,    part,
            part_table, partner,      part_box,      patch_count};
  }
};

}  // namespace gliss
