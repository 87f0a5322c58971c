// Runs the built program and catches what it says.
#pragma once

#include <string>
#include <vector>

namespace carom::test {

struct Outcome {
    int code = -1;  ///< exit code; -1: ended by a signal
    std::string out, err;
};

/// Runs `carom` with the arguments, without a shell, stdin empty, both streams into pipes of their own.
[[nodiscard]] Outcome carom(const std::vector<std::string>& arguments);

/// Expects it to refuse them before anything runs: code 2, nothing on stdout, and a message that holds each of `named`.
void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& named);

/// A fresh folder, removed with everything in it at the end of its life.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::string path(const std::string& name) const { return path_ + "/" + name; }
    /// Writes a file. @return its path.
    std::string write(const std::string& name, const std::string& text) const;

private:
    std::string path_;
};

}  // namespace carom::test
