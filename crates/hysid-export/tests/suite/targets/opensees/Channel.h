#pragma once
#include "Vector.h"

class Channel
{
  public:
    virtual ~Channel() {}
    virtual int sendVector(int dbTag, int commitTag, const Vector &vector) = 0;
    virtual int recvVector(int dbTag, int commitTag, Vector &vector) = 0;
};
