#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "assets/base/worker_pool.h"

namespace relume {

/// Calls work(begin, end) for 0..count - 1 in portions of `portion` numbers, on all threads of the pool.
template<typename Work>
void runPortions(WorkerPool& pool, size_t count, size_t portion, const Work& work) {
    pool.run(static_cast<uint32_t>((count + portion - 1) / portion), [&](uint32_t number) {
        const size_t begin = number * portion;
        work(begin, std::min(count, begin + portion));
    });
}

/// Returns the sum of term(i) over 0..count - 1, which all threads of the pool add up. Portions are the same
/// however many there are, so that it rounds alike.
template<typename Term>
double sumOverAll(WorkerPool& pool, size_t count, const Term& term) {
    constexpr size_t kPortion = size_t{1} << 12;
    std::vector<double> sums((count + kPortion - 1) / kPortion, 0.0);
    runPortions(pool, count, kPortion, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i)
            sum += term(i);
        sums[begin / kPortion] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Returns those of 0..count - 1 that takes(number) is true of, ascending; all threads of the pool ask.
template<typename Takes>
std::vector<uint32_t> numbersWhere(WorkerPool& pool, size_t count, const Takes& takes) {
    constexpr size_t kLeast = size_t{1} << 10, kMost = size_t{1} << 16; // of a portion
    constexpr size_t kOfThread = 4;                                     // portions, for an even end
    const size_t portion = std::clamp(count / (kOfThread * pool.size()), kLeast, kMost);
    std::vector<std::vector<uint32_t>> found((count + portion - 1) / portion);
    runPortions(pool, count, portion, [&](size_t begin, size_t end) {
        std::vector<uint32_t>& own = found[begin / portion];
        for (size_t i = begin; i < end; ++i)
            if (takes(i)) own.push_back(static_cast<uint32_t>(i));
    });
    std::vector<size_t> place; // of what each portion found
    size_t total = 0;
    for (const std::vector<uint32_t>& own : found) {
        place.push_back(total);
        total += own.size();
    }
    std::vector<uint32_t> all(total);
    pool.run(static_cast<uint32_t>(found.size()), [&](uint32_t number) {
        std::copy(found[number].begin(), found[number].end(),
                  all.begin() + static_cast<ptrdiff_t>(place[number]));
    });
    return all;
}

} // namespace relume
