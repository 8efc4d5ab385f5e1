#pragma once
#include <vector>

class Vector
{
  public:
    explicit Vector(int size) : values(size) {}
    double &operator()(int index) { return values.at(index); }
    int Size(void) const { return static_cast<int>(values.size()); }

  private:
    std::vector<double> values;
};
