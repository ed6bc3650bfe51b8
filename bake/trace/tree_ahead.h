#pragma once

#include <future>

#include "bake/trace/moving_bvh.h"

namespace relume {

/// Builds the tree of the `bvh` tracer on a thread of its own, from a copy of the corners: patches, which are
/// made of the same triangles, need not wait for it.
class TreeAhead {
public:
    TreeAhead(const WorldMesh& mesh, WorkerPool& pool);
    /// Returns the tree once it is built, for once. Throws what building it threw.
    MovingBvh take() { return tree_.get(); }

private:
    std::future<MovingBvh> tree_; // waits for the thread when it goes
};

} // namespace relume
