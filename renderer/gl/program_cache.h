#pragma once

#include <cstdint>
#include <map>

#include "renderer/gl/program.h"

namespace relume::gl {

/// Variants of programs by the caller's keys, each made when it is first asked for.
class ProgramCache {
public:
    /// makeDesc() -> Program::Desc, called once per key. Throws Error as Program does.
    template<typename MakeDesc>
    const Program& get(uint32_t key, MakeDesc makeDesc) {
        const auto found = entries_.find(key);
        if (found != entries_.end()) return found->second.program;
        Program::Desc desc = makeDesc();
        Program program(desc);
        return entries_.emplace(key, Entry{std::move(desc), std::move(program)}).first->second.program;
    }

    /// The same variants compiled from what the shaders are now; this one stays as it is. Throws Error.
    ProgramCache reloaded() const;

private:
    struct Entry {
        Program::Desc desc;
        Program program;
    };
    std::map<uint32_t, Entry> entries_;
};

} // namespace relume::gl
