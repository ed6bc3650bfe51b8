#!/usr/bin/env python3
"""Says what a bake would take on many GPUs, by a model of what was measured on one and two: see many_gpus.md.

many_gpus.py

Prints that page's tables (Markdown). All times are seconds of the solver.
"""

from dataclasses import dataclass
from math import sqrt

LINK = 25e9  # [bytes/s], 200 Gbit/s for each GPU
STAGE = 38e9  # [bytes/s], to and from the host's memory, measured
MEETING = 0.5e-3  # [s], what a bounce's exchange takes however little is sent, measured
BYTES_SENT = 8  # by a patch, at a bounce
CHUNK = 64  # patches
MOST_RUNS, LEAST_RUN = 32, 256  # of a rank, and chunks of each (bake/ranks/chunk_deal.h)
GPUS = (1, 2, 8, 64, 512)


@dataclass
class Bake:
    """What was measured of a bake."""

    name: str
    patches: float
    bounces: int
    work1: float  # that the GPU works, on one
    work2: float  # that the busier one of two works
    host: float  # that the GPU waits for what its host does of all chunks
    near2: float  # that two exchange what is near, for smoothing
    two: float  # the solver, on two


LUCY = Bake("CornellLucy, 4096 x 4096, `--error 0.01`", 12.29e6, 35, 5.02, 2.61, 0.44, 0.087, 3.31)
TOWN = Bake("town, 2048 x 2048, `--error 0.01 --local-error 0`", 3.49e6, 26, 1.27, 0.78, 0.114, 0.047, 1.00)
# Here `two` has twice the texels; what lies near hardly counts, as the error is looked at twice only.
WEAK = Bake("CornellLucy, 2896 x 2896 for each GPU, `--samples 256`", 6.14e6, 37, 1.65, 0.83, 0.067, 0.004, 1.94)


def near_share(patches, ranks):
    """The share of a rank's chunks that lie at the edge of its runs, were these squares of chunks."""
    chunks = patches / CHUNK
    runs = ranks * min(MOST_RUNS, max(1.0, chunks / (ranks * LEAST_RUN)))
    return min(1.0, 4 / sqrt(chunks / runs))


def sent(bake, ranks, one_machine):
    """An own share goes out and all others' come in, which is one array; between machines by the network, too."""
    if ranks == 1:
        return 0.0
    size = BYTES_SENT * bake.patches
    network = 0.0 if one_machine else size * (ranks - 1) / ranks / LINK
    return bake.bounces * (MEETING + size / STAGE + network)


def parts(bake, ranks, one_machine=False):
    """The work that is dealt, the longest rays and starts of passes, which are not, the host's, sent, near."""
    fixed = max(0.0, 2 * bake.work2 - bake.work1)
    near = 0.0
    if ranks > 1:
        near = bake.near2 * near_share(bake.patches, ranks) / ranks / (near_share(bake.patches, 2) / 2)
    return ((bake.work1 - fixed) / ranks, fixed, bake.host, sent(bake, ranks, one_machine), near)


def grown(bake, times):
    """The same bake of so many times the texels."""
    fixed = max(0.0, 2 * bake.work2 - bake.work1)
    work = times * (bake.work1 - fixed) + fixed
    return Bake(bake.name, times * bake.patches, bake.bounces, work, (work + fixed) / 2, times * bake.host,
                times * bake.near2, bake.two)


def table(bake, of):
    """A row per number of GPUs; `of` returns what so many bake, and what that is worth [of one GPU's speed]."""
    print(f"\n**{bake.name}**\n")
    print("| GPUs | rays dealt | not dealt | host | sent | near | solver | of one GPU's speed | of N |")
    print("|---|---|---|---|---|---|---|---|---|")
    alone = sum(parts(of(1)[0], 1))
    for ranks in GPUS:
        whole, worth = of(ranks)
        each = parts(whole, ranks)
        speed = worth * alone / sum(each)
        cells = [f"{value:.3f}" for value in each] + [f"{sum(each):.2f} s", f"{speed:.1f}", f"{speed / ranks:.0%}"]
        print(f"| {ranks} | " + " | ".join(cells) + " |")


def main():
    print("| bake on two GPUs of one machine | measured | by the model |\n|---|---|---|")
    for bake, whole in ((LUCY, LUCY), (TOWN, TOWN), (WEAK, grown(WEAK, 2))):
        print(f"| {bake.name} | {bake.two:.2f} s | {sum(parts(whole, 2, one_machine=True)):.2f} s |")
    for bake in (LUCY, TOWN):
        table(bake, lambda ranks, bake=bake: (bake, 1))
    table(WEAK, lambda ranks: (grown(WEAK, ranks), ranks))


if __name__ == "__main__":
    main()
