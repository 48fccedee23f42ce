#pragma once

/// The three kinds of failure a user can meet, each with its exit code. Everything else is a programmer's mistake.

#include <stdexcept>
#include <string>

namespace kerf {

/// What a user sees: where (file:line), what (parameter path, value), which rule was broken, and what to do.
/// Empty parts are left out of the message.
struct Complaint {
  std::string file = {};
  int line = 0;
  std::string path = {};  ///< parameter path, "Body liver/Material/Density [kg per m3]"
  std::string value = {}; ///< the offending value as it was written
  std::string rule = {};  ///< what must hold
  std::string remedy = {};
};

/// "file:line: path = 'value': rule. remedy."
std::string to_string(const Complaint& complaint);

/// A message without line breaks, for tables.
std::string in_one_line(std::string message);

class Error : public std::runtime_error {
 public:
  int exit_code() const { return exit_code_; }

 protected:
  Error(const std::string& message, int exit_code) : std::runtime_error(message), exit_code_(exit_code) {}

 private:
  int exit_code_;
};

/// The scene asks for what cannot be: exit code 1.
class ParameterError : public Error {
 public:
  explicit ParameterError(const Complaint& complaint) : Error(to_string(complaint), 1), complaint_(complaint) {}
  explicit ParameterError(const std::string& message) : Error(message, 1) {}
  const Complaint& complaint() const { return complaint_; }

 private:
  Complaint complaint_;
};

/// A file cannot be read, holds what we cannot use, or cannot be written: exit code 2.
class DataError : public Error {
 public:
  explicit DataError(const Complaint& complaint) : Error(to_string(complaint), 2) {}
  explicit DataError(const std::string& message) : Error(message, 2) {}
};

/// The computation failed: exit code 3. The message names body, step, time and quantity.
class NumericalError : public Error {
 public:
  explicit NumericalError(const std::string& message) : Error(message, 3) {}
};

} // namespace kerf
