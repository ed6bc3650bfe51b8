#include "bake/ranks/mpi_ranks.h"

#include "assets/base/error.h"

#include <unistd.h>

#include <limits>
#include <numeric>
#include <string>

#ifdef RELUME_HAS_MPI
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#endif

namespace relume {

#ifdef RELUME_HAS_MPI
namespace {

// MPI counts in int: what is sent is counted in pieces of so many bytes that this is enough.
class Piece {
public:
    explicit Piece(uint64_t bytes) {
        ASSERT(bytes > 0 && bytes <= uint64_t{std::numeric_limits<int>::max()});
        MPI_Type_contiguous(static_cast<int>(bytes), MPI_BYTE, &type_);
        MPI_Type_commit(&type_);
    }
    ~Piece() { MPI_Type_free(&type_); }
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;
    MPI_Datatype type() const { return type_; }

private:
    MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

int countOf(uint64_t bytes, uint64_t each) {
    const uint64_t count = bytes / each;
    ASSERT(count <= uint64_t{std::numeric_limits<int>::max()});
    return static_cast<int>(count);
}

// A failure of MPI itself ends all processes with a message of MPI: that is its default, which is kept.
class MpiRanks final : public Ranks {
public:
    MpiRanks(uint32_t rank, uint32_t count) : Ranks(rank, count) {}
    ~MpiRanks() override { MPI_Finalize(); }

private:
    uint32_t least(uint32_t value) override {
        uint32_t smallest = value;
        MPI_Allreduce(&value, &smallest, 1, MPI_UINT32_T, MPI_MIN, MPI_COMM_WORLD);
        return smallest;
    }

    void gatherAll(std::span<const std::byte> own, std::span<std::byte> all,
                   std::span<const uint64_t> sizes) override {
        uint64_t each = 0;
        for (const uint64_t size : sizes)
            each = std::gcd(each, size);
        if (each == 0) return; // nobody has anything
        while (each > uint64_t{std::numeric_limits<int>::max()})
            each = each % 2 == 0 ? each / 2 : 1;
        std::vector<int> counts, places;
        uint64_t place = 0;
        for (const uint64_t size : sizes) {
            counts.push_back(countOf(size, each));
            places.push_back(countOf(place, each));
            place += size;
        }
        const Piece piece(each);
        MPI_Allgatherv(own.data(), countOf(own.size(), each), piece.type(), all.data(), counts.data(),
                       places.data(), piece.type(), MPI_COMM_WORLD);
    }

    void exchangeSome(std::span<const Sent> sent, std::span<const Received> received) override {
        // A message goes in parts that int counts, in their order.
        constexpr uint64_t kPart = uint64_t{1} << 30;
        std::vector<MPI_Request> requests;
        for (const Received& message : received)
            for (uint64_t done = 0; done < message.bytes.size(); done += kPart)
                MPI_Irecv(message.bytes.data() + done,
                          static_cast<int>(std::min<uint64_t>(kPart, message.bytes.size() - done)), MPI_BYTE,
                          static_cast<int>(message.from), 0, MPI_COMM_WORLD, &requests.emplace_back());
        for (const Sent& message : sent)
            for (uint64_t done = 0; done < message.bytes.size(); done += kPart)
                MPI_Isend(message.bytes.data() + done,
                          static_cast<int>(std::min<uint64_t>(kPart, message.bytes.size() - done)), MPI_BYTE,
                          static_cast<int>(message.to), 0, MPI_COMM_WORLD, &requests.emplace_back());
        MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    }

    void sumAll(std::span<uint64_t> values) override {
        MPI_Allreduce(MPI_IN_PLACE, values.data(), countOf(values.size(), 1), MPI_UINT64_T, MPI_SUM,
                      MPI_COMM_WORLD);
    }

    // The first rank names the block after itself, and the others open it under that name.
    SharedBlock shareAll(uint64_t bytes) override {
        if (!onOneMachine()) return {};
        uint64_t maker[2] = {static_cast<uint64_t>(getpid()), blocks_++};
        MPI_Bcast(maker, 2, MPI_UINT64_T, 0, MPI_COMM_WORLD);
        const std::string name = "/relume-" + std::to_string(maker[0]) + "-" + std::to_string(maker[1]);
        SharedBlock block;
        if (speaks()) block = createSharedBlock(name, bytes);
        const bool made = fromSpeaker(bool(block));
        if (made && !speaks()) block = openSharedBlock(name, bytes);
        const bool opened = least(block ? 1 : 0) == 1;
        if (made && speaks()) forgetSharedBlock(name);
        return opened ? block : SharedBlock{};
    }

    static bool fromSpeaker(bool value) {
        int word = value ? 1 : 0;
        MPI_Bcast(&word, 1, MPI_INT, 0, MPI_COMM_WORLD);
        return word == 1;
    }

    bool onOneMachine() const {
        MPI_Comm machine = MPI_COMM_NULL;
        MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
        int here = 0;
        MPI_Comm_size(machine, &here);
        MPI_Comm_free(&machine);
        return static_cast<uint32_t>(here) == count();
    }

    uint64_t blocks_ = 0; // that this rank has named
};

} // namespace

bool hasMpi() {
    return true;
}

std::unique_ptr<Ranks> startMpi(const Launch& launch) {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    int rank = 0, count = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    auto ranks = std::make_unique<MpiRanks>(static_cast<uint32_t>(rank), static_cast<uint32_t>(count));
    if (ranks->count() != launch.count || ranks->rank() != launch.rank)
        throw Error("the launcher says " + std::to_string(launch.count) + " processes, MPI " +
                    std::to_string(count) +
                    ": start relume by the mpirun of the MPI that it was built with, or by srun --mpi=pmix");
    return ranks;
}

#else

bool hasMpi() {
    return false;
}

std::unique_ptr<Ranks> startMpi(const Launch& launch) {
    throw UsageError("this relume was built without MPI and cannot share a bake among " +
                     std::to_string(launch.count) +
                     " processes: install libopenmpi-dev and build it anew, or start it without mpirun");
}

#endif

} // namespace relume
