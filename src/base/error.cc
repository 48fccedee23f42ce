#include "base/error.h"

#include <algorithm>

namespace kerf {

namespace {

/// A text on one line; of one that is longer than anybody reads, what tells it from others.
std::string echoed(const std::string& text, const std::size_t most = 400) {
  const std::size_t end = most / 10;
  std::string line = text.size() <= most ? text
                                         : text.substr(0, most - end) + "..." + text.substr(text.size() - end) + " (" +
                                             std::to_string(text.size()) + " characters)";
  std::replace_if(
    line.begin(), line.end(), [](const unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return line;
}

} // namespace

std::string to_string(const Complaint& c) {
  constexpr std::size_t most_of_a_sentence = 2000;
  std::string text;
  if (!c.file.empty())
    text += echoed(c.file) + (c.line > 0 ? ":" + std::to_string(c.line) : "") + ": ";
  if (!c.path.empty())
    text += echoed(c.path) + (c.value.empty() ? "" : " = '" + echoed(c.value) + "'") + ": ";
  else if (!c.value.empty())
    text += "'" + echoed(c.value) + "': ";
  text += echoed(c.rule, most_of_a_sentence);
  if (!c.remedy.empty())
    text += ". " + echoed(c.remedy, most_of_a_sentence);
  return text.ends_with('.') || text.ends_with('?') ? text : text + ".";
}

std::string in_one_line(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message;
}

} // namespace kerf
