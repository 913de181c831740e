# Fails unless the guide prints the file, letter for letter.
file(READ ${FILE} code)
file(READ ${GUIDE} text)
string(FIND "${text}" "```cpp\n${code}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${GUIDE} does not print ${FILE} as it is; copy the file into its block of C++")
endif()
