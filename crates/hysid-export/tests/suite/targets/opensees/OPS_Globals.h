#pragma once
#include "OPS_Stream.h"
extern double ops_Dt;
extern OPS_Stream opserr;
