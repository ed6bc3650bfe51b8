#pragma once

#include <string>
#include <vector>

namespace relume {

/// Says how large a class is, by a count of the declarations in its body.
struct ClassSize {
    std::string name;
    size_t data = 0, functions = 0;
};

/// Counts the members of each class and struct that is defined in the text of a C++ file, nested ones by
/// themselves. It goes by the look of declarations, as clang-format leaves them: constants of the class,
/// types and friends count nothing, and a function whose body stands there counts as any other.
std::vector<ClassSize> classSizes(const std::string& source);

/// Returns the names before "::" of the functions that are defined at the start of a line, each once.
std::vector<std::string> classesImplementedIn(const std::string& source);

} // namespace relume
