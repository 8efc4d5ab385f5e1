#pragma once
class FEM_ObjectBroker
{
};
