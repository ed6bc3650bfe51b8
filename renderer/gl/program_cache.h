#pragma once

#include <cstdint>
#include <map>

#include "renderer/gl/program.h"

namespace relume::gl {

/// Holds variants of programs by the caller's keys, each made when it is first asked for.
class ProgramCache {
public:
    /// Returns the program of a key. makeDesc() returns its Program::Desc and is called once per key. Throws
    /// Error as Program does.
    template<typename MakeDesc>
    const Program& get(uint32_t key, MakeDesc makeDesc) {
        const auto found = entries_.find(key);
        if (found != entries_.end()) return found->second.program;
        Program::Desc desc = makeDesc();
        Program program(desc);
        return entries_.emplace(key, Entry{std::move(desc), std::move(program)}).first->second.program;
    }

    /// Returns the same variants compiled from what the shaders are now; this cache stays as it is. Throws
    /// Error.
    ProgramCache reloaded() const;

private:
    struct Entry {
        Program::Desc desc;
        Program program;
    };
    std::map<uint32_t, Entry> entries_;
};

} // namespace relume::gl
