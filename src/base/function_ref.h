#pragma once

/// A reference to something that can be called, for parameters: it allocates nothing, and must not outlive what it
/// refers to.

#include <memory>
#include <type_traits>

namespace kerf {

template <class Signature>
class FunctionRef;

template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  template <class Function>
  requires(!std::is_same_v<std::remove_cvref_t<Function>, FunctionRef> &&
           std::is_invocable_r_v<Result, const Function&, Arguments...>)
    FunctionRef(const Function& function) // NOLINT: as functions are given
    : object_(std::addressof(function)), call_([](const void* object, Arguments... arguments) -> Result {
        return (*static_cast<const Function*>(object))(arguments...);
      }) {}

  Result operator()(Arguments... arguments) const { return call_(object_, arguments...); }

 private:
  const void* object_;
  Result (*call_)(const void*, Arguments...);
};

} // namespace kerf
