#include <carom/cli/make_executor.hpp>

namespace carom::cli {

Result<std::unique_ptr<Executor>> make_executor(int threads) {
    if (threads != 1) {
        return Error{ErrorCode::InvalidArgument, "this build has one thread only; configure with -DCAROM_TBB=ON for more", "--threads"};
    }
    return std::unique_ptr<Executor>{};
}

}  // namespace carom::cli
