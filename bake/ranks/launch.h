#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace relume {

/// What a launcher (mpirun, srun) has said of this process before it did anything: which one of how many it
/// is. A process that nobody launched is the only one.
struct Launch {
    bool byLauncher = false;
    uint32_t rank = 0, count = 1;           // of all processes
    uint32_t localRank = 0, localCount = 1; // of those on this machine

    /// Tells whether several processes are to do one job together.
    bool several() const { return count > 1; }
    /// Tells whether this is the one that speaks for all.
    bool speaks() const { return rank == 0; }
};

/// Returns a variable of the environment, nullptr where there is none.
using Environment = std::function<const char*(const char* name)>;
/// Reads what Open MPI's mpirun, one that speaks PMI (MPICH's, Slurm's srun) or PMIx (srun --mpi=pmix) has
/// left in the environment. A script within an allocation of Slurm is no task of srun: it is alone.
Launch launchOf(const Environment& environment);
/// Does so for this process.
Launch launchOfProcess();

/// Returns how many threads a process may use by default: all of the `usable` cores that it is bound to, or,
/// where it is bound to none of the machine's `cores`, its share of them, 1 at least.
uint32_t threadShare(uint32_t usable, uint32_t cores, uint32_t localCount);
/// Lets this process and a software driver use no more threads than that, unless RELUME_THREADS or
/// LP_NUM_THREADS say otherwise. Call it before threads are made.
void takeThreadShare(const Launch& launch);

} // namespace relume
