# Decorates every float arithmetic result of a disassembled SPIR-V module with NoContraction, so that no device fuses a
# multiplication with an addition: the tracer's arithmetic is that of its C++ compilations. Reads the module twice over:
#   awk -f no_contraction.awk module.spvasm module.spvasm
NR == FNR && $2 == "=" && $3 ~ /^Op(FAdd|FSub|FMul|FDiv|FNegate|FRem|FMod|Dot|VectorTimesScalar|MatrixTimesScalar|VectorTimesMatrix|MatrixTimesVector|MatrixTimesMatrix|OuterProduct)$/ {
  arithmetic[++count] = $1
}
NR == FNR && $1 == "OpDecorate" && $3 == "NoContraction" { decorated[$2] = 1 }
NR == FNR { next }
# The annotation section starts with the module's first decoration.
!done && $1 ~ /^Op(Member)?Decorate/ {
  for (k = 1; k <= count; ++k) if (!(arithmetic[k] in decorated)) print "OpDecorate " arithmetic[k] " NoContraction"
  done = 1
}
{ print }
