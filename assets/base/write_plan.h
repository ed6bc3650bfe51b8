#pragma once

#include <cstdint>
#include <string>

namespace relume {

/// Holds what the file system tells of a path that is to be written, with symbolic links followed.
struct WriteTarget {
    enum class Kind { Missing, Regular, Folder, Stream, Socket }; // Stream: a device or a FIFO

    std::string path;   // as the user gave it, for messages
    std::string real;   // where links lead
    std::string folder; // of `real`

    Kind kind = Kind::Missing;
    int error = 0;       // errno of the look itself, 0: it could be looked at
    int writeError = 0;  // of what is there: why this user may not write it, 0: may
    int folderError = 0; // why no file can be made in the folder, 0: one can
    bool folderExists = true, folderIsFolder = true;
    bool mounted = false;     // something is mounted there
    bool immutable = false;   // chattr +i or +a
    bool folderKeeps = false; // chattr +a: what is in the folder cannot be renamed
    bool sticky = false;      // only a file's owner and the folder's may replace it
    bool alreadyOpen = false; // a name in /proc of what a process has open, as /dev/stdout is
    uint64_t links = 1;       // hard links
    uint32_t mode = 0;        // rights of what is there
    uint32_t owner = 0, group = 0, folderOwner = 0, user = 0; // user: who writes
};

/// Says how a file gets its new content.
enum class WriteWay {
    Refuse,  // it cannot
    Replace, // a new file takes the name
    InPlace, // the file stays and its content is another: all its names show it
    Stream,  // it is opened and written, as a shell does
};

struct WritePlan {
    WriteWay way = WriteWay::Refuse;
    std::string problem; // of Refuse: "is a folder: name a file in it"
};

/// Decides how to write, from what `target` tells alone.
WritePlan planWrite(const WriteTarget& target);

/// Looks at a path. Changes nothing, and opens nothing of what is there: a FIFO without a reader would wait.
WriteTarget lookAtTarget(const std::string& path);

/// Returns where symbolic links lead, up to what is there or would be.
std::string whereLinksLead(const std::string& path);

/// Returns "needs 3 MiB, its disk has 2 MiB left"; the figures differ wherever `needed` is more than `left`
/// [bytes].
std::string lackOfSpace(uint64_t needed, uint64_t left);

} // namespace relume
