#include "bake/vk/memory_ledger.h"

#include <thread>

#include <gtest/gtest.h>

namespace relume::vk {

TEST(MemoryLedger, CountsByOwnerAndNameAndKeepsThePeak) {
    MemoryLedger ledger;
    MemoryLedger::Account& plain = ledger.open("patches");
    ledger.add(plain, 100);
    MemoryLedger::Account* links = nullptr;
    {
        const MemoryOwner owner("links");
        links = &ledger.open("sums");
        ledger.add(*links, 40);
        const MemoryOwner cache("link cache");
        ledger.add(ledger.open("sums"), 5);
    }
    ledger.add(ledger.open("sums"), 1);
    EXPECT_EQ(ledger.bytes(), 146u);
    EXPECT_EQ(ledger.bytesOf("links"), 40u);
    EXPECT_EQ(ledger.bytesOf("link cache"), 5u);
    EXPECT_EQ(ledger.bytesOf(""), 101u) << "the owner is the one before again";
    EXPECT_EQ(ledger.entries().size(), 4u);

    ledger.remove(*links, 40);
    EXPECT_EQ(ledger.bytes(), 106u);
    EXPECT_EQ(ledger.peak(), 146u);
    EXPECT_EQ(ledger.entries().size(), 3u);
    ledger.resetPeak();
    EXPECT_EQ(ledger.peak(), 106u);
}

TEST(MemoryLedger, AnOwnerIsOneThreads) {
    MemoryLedger ledger;
    const MemoryOwner owner("here");
    std::thread([&] { ledger.add(ledger.open("bits"), 7); }).join();
    EXPECT_EQ(ledger.bytesOf("here"), 0u);
    EXPECT_EQ(ledger.bytesOf(""), 7u);
}

TEST(MemoryLedger, LetsOneAllocationFail) {
    MemoryLedger ledger;
    EXPECT_TRUE(ledger.admit());
    ledger.failAt(2);
    EXPECT_TRUE(ledger.admit());
    EXPECT_FALSE(ledger.admit());
    EXPECT_TRUE(ledger.admit());
    EXPECT_EQ(ledger.allocations(), 4u);
    EXPECT_FALSE(ledger.withdrawFailure()) << "it came";
    ledger.failAt(1);
    EXPECT_TRUE(ledger.withdrawFailure());
    EXPECT_TRUE(ledger.admit());
}

} // namespace relume::vk
