#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace relume {

/// Memory that all ranks of one machine see at once. It begins at a page and goes with its last copy.
struct SharedBlock {
    std::shared_ptr<void> owner;
    std::span<std::byte> bytes; // empty where there is none

    explicit operator bool() const { return !bytes.empty(); }
};

/// Makes a block of POSIX shared memory of a name that nobody uses ("/relume-..."). All of it is allocated at
/// once. Returns none where the system has too little of it, or none at all.
SharedBlock createSharedBlock(const std::string& name, uint64_t bytes);
/// Returns a block that another process of this machine has made with as many bytes, or none.
SharedBlock openSharedBlock(const std::string& name, uint64_t bytes);
/// Takes away a block's name; who has opened it keeps it.
void forgetSharedBlock(const std::string& name);

} // namespace relume
