#pragma once

/// stdin, stdout and stderr as whoever starts the program may leave them: closed, a pipe that nobody reads any more, a
/// full disk.

namespace kerf::apps {

/// From now on a pipe that nobody reads ends no run, and none of the three is closed: a file of results would get its
/// number, and what is said would go into that.
void make_streams_safe();

/// Throws DataError where stdout has not taken all that was said; nothing where nobody reads it.
void finish_stdout();

} // namespace kerf::apps
