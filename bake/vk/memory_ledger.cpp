#include "bake/vk/memory_ledger.h"

#include <algorithm>
#include <utility>

#include "assets/base/error.h"

namespace relume::vk {
namespace {

thread_local const char* memoryOwner = "";

} // namespace

MemoryLedger::Account& MemoryLedger::open(const std::string& name, bool ofHost) {
    const std::lock_guard lock(mutex_);
    Account& account = accounts_[{memoryOwner, name, ofHost}];
    account.ofHost = ofHost;
    return account;
}

void MemoryLedger::add(Account& account, uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    account.bytes += bytes;
    bytes_ += bytes;
    peak_ = std::max(peak_, bytes_);
    if (account.ofHost) return;
    deviceBytes_ += bytes;
    devicePeak_ = std::max(devicePeak_, deviceBytes_);
}

void MemoryLedger::remove(Account& account, uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    ASSERT(account.bytes >= bytes && bytes_ >= bytes);
    account.bytes -= bytes;
    bytes_ -= bytes;
    if (!account.ofHost) deviceBytes_ -= bytes;
}

uint64_t MemoryLedger::bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

uint64_t MemoryLedger::deviceBytes() const {
    const std::lock_guard lock(mutex_);
    return deviceBytes_;
}

uint64_t MemoryLedger::bytesOf(const std::string& owner) const {
    const std::lock_guard lock(mutex_);
    uint64_t sum = 0;
    for (const auto& [key, account] : accounts_)
        if (key.owner == owner) sum += account.bytes;
    return sum;
}

uint64_t MemoryLedger::deviceBytesOf(const std::string& owner) const {
    const std::lock_guard lock(mutex_);
    uint64_t sum = 0;
    for (const auto& [key, account] : accounts_)
        if (key.owner == owner && !key.ofHost) sum += account.bytes;
    return sum;
}

uint64_t MemoryLedger::peak() const {
    const std::lock_guard lock(mutex_);
    return peak_;
}

uint64_t MemoryLedger::devicePeak() const {
    const std::lock_guard lock(mutex_);
    return devicePeak_;
}

void MemoryLedger::resetPeak() {
    const std::lock_guard lock(mutex_);
    peak_ = bytes_;
    devicePeak_ = deviceBytes_;
}

std::map<MemoryLedger::Key, uint64_t> MemoryLedger::entries() const {
    const std::lock_guard lock(mutex_);
    std::map<Key, uint64_t> found;
    for (const auto& [key, account] : accounts_)
        if (account.bytes > 0) found[key] = account.bytes;
    return found;
}

uint64_t MemoryLedger::allocations() const {
    const std::lock_guard lock(mutex_);
    return allocations_;
}

void MemoryLedger::failAt(uint64_t n) {
    ASSERT(n > 0);
    const std::lock_guard lock(mutex_);
    untilFailure_ = n;
}

bool MemoryLedger::withdrawFailure() {
    const std::lock_guard lock(mutex_);
    return std::exchange(untilFailure_, {}).has_value();
}

bool MemoryLedger::admit() {
    const std::lock_guard lock(mutex_);
    ++allocations_;
    if (!untilFailure_ || --*untilFailure_ > 0) return true;
    untilFailure_.reset();
    return false;
}

MemoryOwner::MemoryOwner(const char* name) : before_(std::exchange(memoryOwner, name)) {}

MemoryOwner::~MemoryOwner() {
    memoryOwner = before_;
}

} // namespace relume::vk
