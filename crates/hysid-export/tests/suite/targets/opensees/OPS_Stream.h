#pragma once
#include <iostream>

class OPS_Stream
{
  public:
    template <class T> OPS_Stream &operator<<(const T &value)
    {
        std::cerr << value;
        return *this;
    }
};

static const char endln[] = "\n";
