#include <cli/program.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace carom::test {
namespace {

std::string contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void redirect(int stream, const std::string& path, int flags) {
    const int file = open(path.c_str(), flags, 0600);
    if (file < 0 || dup2(file, stream) < 0) _exit(126);
}

}  // namespace

Outcome carom(const std::vector<std::string>& arguments) {
    const TemporaryFolder folder;
    std::vector<std::string> words{CAROM_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const std::string out = folder.path("out"), err = folder.path("err");
    const pid_t child = fork();
    if (child == 0) {
        redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
        redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT | O_TRUNC);
        redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT | O_TRUNC);
        // Mesa's software driver keeps some memory of its own: LeakSanitizer looks at the runs that draw nothing.
        if (std::ranges::find(arguments, "--picture") != arguments.end()) setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
        execv(argv[0], argv.data());
        _exit(127);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) throw std::runtime_error("cannot run the program");
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
}

void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& named) {
    const Outcome outcome = carom(arguments);
    std::string line;
    for (const std::string& word : arguments) {
        line += " " + word;
    }
    EXPECT_EQ(outcome.code, 2) << line;
    EXPECT_EQ(outcome.out, "") << line;
    for (const std::string& name : named) {
        EXPECT_NE(outcome.err.find(name), std::string::npos) << line << "\nsaid: " << outcome.err << "missing: " << name;
    }
}

TemporaryFolder::TemporaryFolder() : path_(std::filesystem::temp_directory_path() / "carom_cli_XXXXXX") {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
}

}  // namespace carom::test
