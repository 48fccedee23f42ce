#include "visibility/cpu_rasteriser.h"

#include "base/parallel.h"
#include "visibility/kernels.h"

namespace kerf::visibility {

// The kernel reads both as plain doubles.
static_assert(sizeof(Disk) == 12 * sizeof(double) && sizeof(Face) == 9 * sizeof(double));

void CpuRasteriser::occlude(const MaskShape& shape, const std::span<const Face> faces,
                            const std::span<const DiskUpdate> updates) {
  constexpr std::size_t worth_a_thread = 64;
  parallel_for(
    updates.size(),
    [&](const std::size_t i) {
      const DiskUpdate& update = updates[i];
      occlude_disk({.frame = update.disk.middle.data(),
                    .faces = faces.empty() ? nullptr : faces.front().front().data(),
                    .which = update.faces.data(),
                    .n = update.faces.size(),
                    .inside = shape.disk().data(),
                    .resolution = shape.resolution(),
                    .end = end_of_lines},
                   update.mask);
    },
    worth_a_thread);
}

} // namespace kerf::visibility
