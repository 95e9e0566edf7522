// GRADUS_FOR_EACH(M, s, a, b, …) expands to M(s, a) M(s, b) …; up to 256 arguments (recursion by __VA_OPT__, C++20).
#pragma once

#define GRADUS_PARENS ()
#define GRADUS_EXPAND(...) GRADUS_EXPAND3(GRADUS_EXPAND3(GRADUS_EXPAND3(GRADUS_EXPAND3(__VA_ARGS__))))
#define GRADUS_EXPAND3(...) GRADUS_EXPAND2(GRADUS_EXPAND2(GRADUS_EXPAND2(GRADUS_EXPAND2(__VA_ARGS__))))
#define GRADUS_EXPAND2(...) GRADUS_EXPAND1(GRADUS_EXPAND1(GRADUS_EXPAND1(GRADUS_EXPAND1(__VA_ARGS__))))
#define GRADUS_EXPAND1(...) __VA_ARGS__

#define GRADUS_FOR_EACH(macro, subject, ...) __VA_OPT__(GRADUS_EXPAND(GRADUS_FOR_EACH_STEP(macro, subject, __VA_ARGS__)))
#define GRADUS_FOR_EACH_STEP(macro, subject, first, ...) \
  macro(subject, first) __VA_OPT__(GRADUS_FOR_EACH_AGAIN GRADUS_PARENS(macro, subject, __VA_ARGS__))
#define GRADUS_FOR_EACH_AGAIN() GRADUS_FOR_EACH_STEP
