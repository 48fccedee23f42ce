#include "base/error.h"

#include <algorithm>

namespace kerf {

namespace {

/// A value as it was written, on one line; of a long one what tells it from others.
std::string echoed(const std::string& value) {
  constexpr std::size_t most = 400, end = 40;
  std::string text = value.size() <= most ? value
                                          : value.substr(0, most - end) + "..." + value.substr(value.size() - end) +
                                              " (" + std::to_string(value.size()) + " characters)";
  std::replace_if(text.begin(), text.end(), [](const unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return text;
}

} // namespace

std::string to_string(const Complaint& c) {
  std::string text;
  if (!c.file.empty())
    text += c.file + (c.line > 0 ? ":" + std::to_string(c.line) : "") + ": ";
  if (!c.path.empty())
    text += echoed(c.path) + (c.value.empty() ? "" : " = '" + echoed(c.value) + "'") + ": ";
  else if (!c.value.empty())
    text += "'" + echoed(c.value) + "': ";
  text += c.rule;
  if (!c.remedy.empty())
    text += ". " + c.remedy;
  return text.ends_with('.') || text.ends_with('?') ? text : text + ".";
}

} // namespace kerf
