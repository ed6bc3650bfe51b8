#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/retrace_types.h"

namespace relume {

/// Lists the triangles, or the patches, of each instance.
class ObjectMembers {
public:
    /// Takes the instance of each member; those of padding have the number `instances`.
    ObjectMembers(const std::vector<uint32_t>& instanceOf, size_t instances);

    /// Returns those of one instance, ascending.
    std::span<const uint32_t> of(uint32_t instance) const {
        return std::span(members_).subspan(first_[instance], first_[instance + 1] - first_[instance]);
    }
    /// Returns those of several instances, ascending.
    std::vector<uint32_t> of(const std::vector<uint32_t>& instances) const;

private:
    std::vector<uint32_t> first_, members_;
};

/// Returns the box around these triangles, grown by more than rays and boxes together round off; nothing
/// where there are none.
std::optional<shader::TraceBox> boxAround(const WorldMesh& mesh, std::span<const uint32_t> triangles);

} // namespace relume
