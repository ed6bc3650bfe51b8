#pragma once

#include "bake/ranks/ranks.h"

#include <algorithm>
#include <barrier>
#include <cstdlib>
#include <functional>
#include <thread>

namespace relume {
namespace thread_ranks {

constexpr size_t kPage = 4096; // [bytes]

/// What threads show each other between two waits.
struct RankTable {
    RankTable(uint32_t count, bool memory)
        : sharesMemory(memory), together(static_cast<std::ptrdiff_t>(count)), words(count), bytes(count),
          sent(count), values(count) {}
    bool sharesMemory;
    std::barrier<> together;
    std::vector<uint32_t> words;
    std::vector<std::span<const std::byte>> bytes;
    std::vector<std::span<const Ranks::Sent>> sent;
    std::vector<std::span<uint64_t>> values;
    SharedBlock block;
};

class ThreadRanks final : public Ranks {
public:
    ThreadRanks(RankTable& table, uint32_t rank, uint32_t count) : Ranks(rank, count), table_(table) {}

private:
    uint32_t least(uint32_t value) override {
        table_.words[rank()] = value;
        table_.together.arrive_and_wait();
        const uint32_t smallest = *std::min_element(table_.words.begin(), table_.words.end());
        table_.together.arrive_and_wait();
        return smallest;
    }
    void gatherAll(std::span<const std::byte> own, std::span<std::byte> all,
                   std::span<const uint64_t>) override {
        table_.bytes[rank()] = own;
        table_.together.arrive_and_wait();
        std::byte* to = all.data();
        for (const std::span<const std::byte>& bytes : table_.bytes)
            to = std::copy(bytes.begin(), bytes.end(), to);
        table_.together.arrive_and_wait();
    }
    void exchangeSome(std::span<const Sent> sent, std::span<const Received> received) override {
        table_.sent[rank()] = sent;
        table_.together.arrive_and_wait();
        for (const Received& message : received)
            for (const Sent& other : table_.sent[message.from])
                if (other.to == rank())
                    std::copy(other.bytes.begin(), other.bytes.end(), message.bytes.begin());
        table_.together.arrive_and_wait();
    }
    void sumAll(std::span<uint64_t> values) override {
        table_.values[rank()] = values;
        table_.together.arrive_and_wait();
        std::vector<uint64_t> sums(values.size(), 0);
        for (const std::span<uint64_t>& one : table_.values)
            for (size_t i = 0; i < sums.size(); ++i)
                sums[i] += one[i];
        table_.together.arrive_and_wait();
        std::copy(sums.begin(), sums.end(), values.begin());
    }

    SharedBlock shareAll(uint64_t bytes) override {
        if (!table_.sharesMemory) return {};
        if (speaks()) {
            table_.block = {std::shared_ptr<void>(std::aligned_alloc(kPage, bytes), &std::free), {}};
            table_.block.bytes = {static_cast<std::byte*>(table_.block.owner.get()), bytes};
        }
        table_.together.arrive_and_wait();
        const SharedBlock block = table_.block;
        table_.together.arrive_and_wait();
        return block;
    }

    RankTable& table_;
};

} // namespace thread_ranks

/// Runs `work` as so many ranks that are threads of this process, and waits for all of them. What one throws
/// ends the program. Without memory that they share they send each other all things.
inline void runThreadRanks(uint32_t count, const std::function<void(Ranks&)>& work,
                           bool sharesMemory = true) {
    thread_ranks::RankTable table(count, sharesMemory);
    std::vector<std::thread> threads;
    for (uint32_t rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
            thread_ranks::ThreadRanks ranks(table, rank, count);
            work(ranks);
        });
    for (std::thread& thread : threads)
        thread.join();
}

} // namespace relume
