// A reference to a callable: no allocation, no ownership.
//
//   void visit(FunctionRef<bool(std::uint32_t)> callback);
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace carom {

template <class Signature>
class FunctionRef;

/// Refers to a callable that outlives the reference (a lambda passed as an argument does).
template <class R, class... Args>
class FunctionRef<R(Args...)> {
public:
    template <class F>
        requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>)
    FunctionRef(F&& callable) noexcept
        : object_(const_cast<void*>(reinterpret_cast<const void*>(std::addressof(callable)))),
          call_([](void* object, Args... args) -> R {
              return (*reinterpret_cast<std::add_pointer_t<std::remove_reference_t<F>>>(object))(std::forward<Args>(args)...);
          }) {}

    R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

private:
    void* object_;
    R (*call_)(void*, Args...);
};

}  // namespace carom
