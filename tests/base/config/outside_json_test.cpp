// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/config/outside_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace handpiece::config::outside_json_test {
namespace {

using Json = nlohmann::ordered_json;

std::string nested(std::size_t depth, const char* open, const char* close) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i)
        text += open;
    text += '1';
    for (std::size_t i = 0; i < depth; ++i)
        text += close;
    return text;
}

TEST(OutsideJson, whatIsNestedTooDeepIsNeverKept) {
    for (const auto& [open, close] : {std::pair{"[", "]"}, {"{\"a\":", "}"}, {"[[1,2],", "]"}}) {
        EXPECT_EQ(jsonProblem(nested(60, open, close)), "");
        // 240 kB of this ended a server: its values were copied by recursion.
        EXPECT_EQ(jsonProblem(nested(120'000, open, close)), "it is nested more than 64 deep");
        EXPECT_TRUE(outsideJson<Json>(nested(120'000, open, close)).is_discarded());
        EXPECT_THROW((void)requireOutsideJson<Json>(nested(120'000, open, close)), Json::exception);
    }
    EXPECT_EQ(jsonProblem(std::string(200'000, '[')), "it is nested more than 64 deep");
}

TEST(OutsideJson, keysAndValuesHaveBounds) {
    std::string keys = "{\"a\":0", values = "[0";
    for (int i = 0; i < 600; ++i)
        keys += ",\"" + std::to_string(i) + "\":0", values += ",0";
    keys += "}", values += "]";
    EXPECT_EQ(jsonProblem(keys), "an object has more than 512 keys");
    EXPECT_EQ(jsonProblem(keys, {.keys = 601}), "");
    EXPECT_EQ(jsonProblem(values), "");
    EXPECT_EQ(jsonProblem(values, {.values = 601}), "it has more than 601 values");
    EXPECT_EQ(jsonProblem(values, {.values = 602}), "");
    // Of each object by itself, and again after one is closed.
    EXPECT_EQ(jsonProblem("[" + std::string("{\"a\":{\"b\":1},\"c\":2},{\"a\":1,\"b\":2}") + "]", {.keys = 2}), "");
    EXPECT_NE(jsonProblem("{\"a\":{\"b\":1},\"c\":2,\"d\":3}", {.keys = 2}), "");
}

TEST(OutsideJson, whatIsWellIsReadAsEver) {
    const std::string text = R"({"z": [1, 2.5, null, true, "\u00e4"], "a": {}})";
    EXPECT_EQ(outsideJson<Json>(text), Json::parse(text));
    EXPECT_EQ(requireOutsideJson<Json>(text).dump(), Json::parse(text).dump()) << "in its order";
    for (const char* damaged : {"", "{", "[1,]", "nul", "{\"a\" 1}", "\"\xff\"", "1 2"}) {
        EXPECT_NE(jsonProblem(damaged), "") << damaged;
        EXPECT_TRUE(outsideJson<Json>(damaged).is_discarded());
    }
}

}  // namespace
}  // namespace handpiece::config::outside_json_test
