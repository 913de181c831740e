# The page that computes in a browser: what the dashboard computes, as one WebAssembly module (decision 0033). No sockets, no threads.
set(computed answers curves http identify_view json_request machines uploads what_if)
list(TRANSFORM computed APPEND .cpp)
add_executable(stribeck_offline ${computed} offline/offline.cpp)
target_link_libraries(stribeck_offline PRIVATE stribeck::workflow stribeck_flags)
target_include_directories(stribeck_offline PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(stribeck_offline PRIVATE STRIBECK_VERSION="${PROJECT_VERSION}")
stribeck_texts(stribeck_offline)
target_link_options(stribeck_offline PRIVATE
  -sMODULARIZE -sEXPORT_NAME=stribeck -sENVIRONMENT=worker,node -sALLOW_MEMORY_GROWTH -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=4MB
  -sEXPORTED_RUNTIME_METHODS=ccall,UTF8ToString,HEAPU8,FS -sEXPORTED_FUNCTIONS=_malloc,_free -sFILESYSTEM=1 --no-entry)
