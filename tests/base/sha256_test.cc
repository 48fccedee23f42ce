// SHA-256 against the examples of FIPS 180-2 and its appendix, and across the sizes at which blocks end.

#include "base/sha256.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <fstream>

namespace kerf::sha256_test {
namespace {

std::string of(const std::string& text) { return sha256(std::as_bytes(std::span(text))); }

TEST(Sha256, IsTheStandards) {
  EXPECT_EQ(of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(of(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const auto path = std::filesystem::temp_directory_path() / "kerf_sha256_test";
  for (const std::size_t n : {0, 1, 55, 56, 63, 64, 65, 65535, 65536, 65537, 200000}) {
    const std::string text(n, 'k');
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(sha256_of_file(path), of(text)) << n;
  }
  std::filesystem::remove(path);
  EXPECT_THROW(sha256_of_file(path), DataError);
}

} // namespace
} // namespace kerf::sha256_test
