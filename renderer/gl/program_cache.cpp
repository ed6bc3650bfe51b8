#include "renderer/gl/program_cache.h"

namespace relume::gl {

ProgramCache ProgramCache::reloaded() const {
    ProgramCache made;
    for (const auto& [key, entry] : entries_)
        made.entries_.emplace(key, Entry{entry.desc, Program(entry.desc)});
    return made;
}

} // namespace relume::gl
