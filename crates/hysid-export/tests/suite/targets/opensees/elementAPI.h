#pragma once
extern "C" int OPS_GetIntInput(int *count, int *values);
