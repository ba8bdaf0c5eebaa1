#pragma once

#include "app/sweep/folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace souple::app {

/// Writes an array job of Slurm: a task for each run. `arguments` are those of this program, for all runs. Throws Error.
void write_slurm_script(const std::filesystem::path& file, const Sweep& sweep,
                        const std::vector<std::string>& arguments);

/// A word as a shell reads it back.
std::string shell_word(const std::string& text);

}  // namespace souple::app
