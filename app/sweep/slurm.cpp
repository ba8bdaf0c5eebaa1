#include "app/sweep/slurm.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"

#include <system_error>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

std::string shell_word(const std::string& text) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c;
    }
  }
  return out + "'";
}

void write_slurm_script(const fs::path& file, const Sweep& sweep, const std::vector<std::string>& arguments) {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) program = "souple";
  std::string command = "\"${SOUPLE_PROGRAM:-" + shell_word(program.string()) + "}\"";
  for (const std::string& argument : arguments) command += " " + shell_word(argument);
  const fs::path log = fs::absolute(sweep.out) / "slurm_%a.log";
  if (log.string().find_first_of("\"\n\r\\") != std::string::npos)
    throw Error(sweep.out.string() + ": Slurm cannot write into a folder of this name; choose another --out");
  std::string text = "#!/bin/bash\n";
  text +=
      "# An array job, made by `souple sweep --slurm`: sbatch FILE. A task is a run; one that is repeated "
      "changes nothing.\n";
  text += "# After the last task: bash FILE --table\n";
  text += fmt::format("#SBATCH --job-name=souple-{}\n#SBATCH --array=1-{}\n", sweep.name, sweep.plan.runs());
  text += "#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n#SBATCH --requeue\n#SBATCH --open-mode=append\n";
  text += fmt::format("#SBATCH --output=\"{}\"\n", log.string());
  text += fmt::format("cd {} || exit 1\n", shell_word(fs::current_path().string()));
  text += "part=(--only \"${SLURM_ARRAY_TASK_ID:-1}\")\n[ \"${1:-}\" != --table ] || part=(--table)\n";
  text += "exec " + command + " \"${part[@]}\"\n";
  write_file_atomically(file, text);
}

}  // namespace souple::app
