#pragma once
#define OPS_Export extern "C"
extern "C" int OPS_GetIntInput(int *count, int *values);
