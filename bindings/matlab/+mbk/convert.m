function [result, info] = convert(varargin)
% mbk.convert  A recording in another format.
%
%   RESULT = mbk.convert(...) is the document that 'mbk convert --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.convert(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.convert({'log.mat', 'log.h5'}, NAME, VALUE, ...)
%   RESULT is the line that the program prints.
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.read
  [result, info] = mbk.internal.run('convert', varargin);
end
