#pragma once

#include "bake/probes/probe_links.h"
#include "bake/solver/solver.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"

namespace relume {

struct BakeSettings {
    uint32_t size = 512; // lightmap edge [texels]
    bool conservative = false;
    TracerKind tracer = TracerKind::Auto;
    VoxelSettings voxels;   // of the voxel tracer; a ratio above 0 mixes it with `tracer`
    SolverSettings solver;  // solver.transport.rtrad makes the whole bake follow RTRad
    ProbeExtent probes;     // that are baked at its end, for which memory is left
    Ranks* ranks = nullptr; // that bake together and outlive the bake; nullptr: one process
};

} // namespace relume
