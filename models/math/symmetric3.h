/* symmetric3.h - eigenvalues and eigenvectors of a symmetric 3x3 matrix, from + - * / sqrt, for prepare. */
#ifndef MODELS_SYMMETRIC3_H
#define MODELS_SYMMETRIC3_H

/* Cyclic Jacobi rotations, at most 12 sweeps (5 are usual, of 150 operations each). value[] ascends;
 * vector[k] is the unit vector of value[k]. a is overwritten. Errors of value: a few rounding errors of the
 * largest. */
void symmetric3_eigen(double a[3][3], double value[3], double vector[3][3]);

#endif
