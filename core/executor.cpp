#include <carom/core/executor.hpp>

namespace carom {

void SerialExecutor::parallel_for(std::size_t count, std::size_t /*grain*/, Body body) {
    if (count > 0) body(0, count);
}

}  // namespace carom
