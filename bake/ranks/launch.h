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

/// The cores of a machine, and those of them that this process is bound to: all of them where it is not.
struct Cores {
    uint32_t usable = 1, all = 1;
};
Cores coresOfProcess();
/// Returns how many threads a process may use by default: as many as the cores that it is bound to, or, where
/// it is not bound, its share of them, 1 at least.
uint32_t threadShare(const Cores& cores, uint32_t localCount);
/// Tells whether the launcher has bound the process to fewer cores than its share.
bool boundTight(const Cores& cores, uint32_t localCount);
/// Lets this process and a software driver use no more threads than that, unless RELUME_THREADS or
/// LP_NUM_THREADS say otherwise. Call it before threads are made.
void takeThreadShare(const Launch& launch);

} // namespace relume
